/* Cortex-M0 of the nRF51 at 16 MHz: serial line, and a tick of 10 ms. */
#include "block.h"
#include "processor.h"

/* Returns a register. */
#define AT(address) (*(volatile uint32_t *)(address))

#define UART_START_RX AT(0x40002000)
#define UART_START_TX AT(0x40002008)
#define UART_RX_READY AT(0x40002108)
#define UART_TX_READY AT(0x4000211C)
#define UART_INTERRUPTS_ON AT(0x40002304)
#define UART_INTERRUPTS_OFF AT(0x40002308)
#define UART_ENABLE AT(0x40002500)
#define UART_TX_PIN AT(0x4000250C)
#define UART_RX_PIN AT(0x40002514)
#define UART_RX AT(0x40002518)
#define UART_TX AT(0x4000251C)
#define UART_BAUD AT(0x40002524)

#define TIMER_START AT(0x40008000)
#define TIMER_COMPARED AT(0x40008140)
#define TIMER_SHORTS AT(0x40008200)
#define TIMER_INTERRUPTS AT(0x40008304)
#define TIMER_PRESCALER AT(0x40008510)
#define TIMER_COMPARE AT(0x40008540)

#define INTERRUPTS AT(0xE000E100)
#define UART_INTERRUPT 2u
#define TIMER_INTERRUPT 8u
/* Event in which a byte has arrived. */
#define UART_RECEIVED (1u << 2)

extern uint8_t stack_top[];
extern uint32_t bss_start[];
extern uint32_t _end[];

int main(void);

static volatile uint8_t ticks;
static bool is_sending;

static void reset(void) {
    uint32_t *at;
    for (at = bss_start; at < _end; at++) {
        *at = 0;
    }
    (void)main();
}

static void count_tick(void) {
    TIMER_COMPARED = 0;
    ticks++;
}

/* A byte has arrived. On hardware, store it here: the UART has room for six bytes. */
static void wake(void) {
    UART_INTERRUPTS_OFF = UART_RECEIVED;
}

/* Initial stack, and handlers: 15 exceptions, then interrupts. */
__attribute__((section(".vectors"), used)) static const void *const vectors[16 + TIMER_INTERRUPT +
                                                                            1] = {
    [0] = stack_top,
    [1] = (const void *)reset,
    [16 + UART_INTERRUPT] = (const void *)wake,
    [16 + TIMER_INTERRUPT] = (const void *)count_tick,
};

uint8_t port_clock(void) {
    return ticks;
}

void processor_start(void) {
    UART_TX_PIN = 24; /* Pins of the micro:bit. */
    UART_RX_PIN = 25;
    UART_ENABLE = 4;
    UART_BAUD = 0x10000000; /* 1,000,000 baud */
    UART_START_RX = 1;
    UART_START_TX = 1;
    TIMER_PRESCALER = 4; /* 1 MHz */
    TIMER_COMPARE = 10000;
    TIMER_SHORTS = 1; /* Start again after the comparison. */
    TIMER_INTERRUPTS = 1u << 16;
    TIMER_START = 1;
    INTERRUPTS = (1u << UART_INTERRUPT) | (1u << TIMER_INTERRUPT);
}

int16_t processor_read(void) {
    if (UART_RX_READY == 0u) {
        return -1;
    }
    UART_RX_READY = 0;
    return (int16_t)(UART_RX & 0xFFu);
}

void processor_write(uint8_t byte) {
    while (is_sending && (UART_TX_READY == 0u)) {
    }
    is_sending = true;
    UART_TX_READY = 0;
    UART_TX = byte;
}

void processor_rest(void) {
    UART_INTERRUPTS_ON = UART_RECEIVED;
    __asm volatile("wfi");
}
