/* Sizes for tests: a program of any size, loaded at run time. */
#ifndef SA_PROGRAM_H
#define SA_PROGRAM_H

#include <stdint.h>

#define SA_SEEN 127u
#define SA_RULES 255u
#define SA_WAITING 512u
#define SA_SEEDS 256u

extern uint8_t sa_program[65536];
#define SA_READ(at) (sa_program[(at)])

#endif
