/* Sizes for tests: a program of any size, loaded at run time. */
#ifndef SA_PROGRAM_H
#define SA_PROGRAM_H

#include <stdint.h>

#ifdef SMALL
/* A state is stored often. */
#define SA_SEEN 32u
#define SA_RULES 32u
#define SA_WAITING 8u
#define SA_SEEDS 4u
#else
#define SA_SEEN 127u
#define SA_RULES 255u
#define SA_WAITING 512u
#define SA_SEEDS 256u
#endif

extern uint8_t sa_program[65536];
#define SA_READ(at) (sa_program[(at)])

#endif
