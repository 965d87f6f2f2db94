// Measures the CPU time of a message in VisibleSim, in which cubes of a row pass a message on.
//
// visiblesim MESSAGES ROUNDS -f -t -c CONFIG. The first cube sends a message to its neighbour, and each cube passes it on. At an
// end of the row, the message turns back. Prints the CPU time of a message in each round [ns], after a round of warm-up.
#include <cstdio>
#include <cstdlib>
#include <ctime>

#include "robots/slidingCubes/slidingCubesBlockCode.h"
#include "robots/slidingCubes/slidingCubesSimulator.h"

using namespace SlidingCubes;

static const int TOKEN = 1001;
static long per_round, rounds, received;
static double start;

static double cpu_time() {
    timespec time;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
    return time.tv_sec + 1e-9 * time.tv_nsec;
}

class Pass : public SlidingCubesBlockCode {
    SlidingCubesBlock *block;

    /// Sends the message to a neighbour other than `from`, or back if there is none.
    void pass(P2PNetworkInterface *from) {
        P2PNetworkInterface *to = from;
        for (auto *it : block->getP2PNetworkInterfaces())
            if (it->connectedInterface && it != from) to = it;
        sendMessage(new Message(TOKEN), to, 100, 0);
    }

    void receive(P2PNetworkInterface *from) {
        if (received % per_round == 0) {
            double time = cpu_time();
            if (received > per_round) printf("%.1f\n", 1e9 * (time - start) / per_round);
            start = time;
        }
        if (++received > per_round * (rounds + 1)) {
            fflush(stdout);
            _Exit(0);
        }
        pass(from);
    }

public:
    Pass(SlidingCubesBlock *host) : SlidingCubesBlockCode(host), block(host) {}

    void startup() override {
        addMessageEventFunc2(TOKEN, [this](std::shared_ptr<Message>, P2PNetworkInterface *from) { receive(from); });
        if (block->blockId == 1) pass(nullptr);
    }

    static BlockCode *create(BuildingBlock *host) { return new Pass((SlidingCubesBlock *)host); }
};

int main(int argc, char **argv) {
    per_round = atol(argv[1]);
    rounds = atol(argv[2]);
    argv[2] = argv[0];
    createSimulator(argc - 2, argv + 2, Pass::create);
}
