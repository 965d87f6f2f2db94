/* Runs a program on an emulated ATmega328P. Its serial line is the standard input and output. */
#include <poll.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stdio.h>
#include <unistd.h>

#include <simavr/avr_uart.h>
#include <simavr/sim_avr.h>
#include <simavr/sim_elf.h>
#include <simavr/sim_time.h>

/* Emulated time between two reads of the standard input [us]. */
#define INTERVAL 1000

static avr_irq_t *line;
static bool is_full;

static void log_errors(avr_t *avr, const int level, const char *format, va_list values) {
    (void)avr;
    if (level <= LOG_ERROR) {
        (void)vfprintf(stderr, format, values);
    }
}

static void set_full(avr_irq_t *irq, uint32_t value, void *is_now_full) {
    (void)irq;
    (void)value;
    is_full = is_now_full != NULL;
}

static void output(avr_irq_t *irq, uint32_t value, void *unused) {
    (void)irq;
    (void)unused;
    (void)putchar((int)value);
}

/* Moves bytes between the line and the standard input and output. */
static avr_cycle_count_t transfer(avr_t *avr, avr_cycle_count_t when, void *unused) {
    struct pollfd ready = {.fd = STDIN_FILENO, .events = POLLIN};
    (void)unused;
    (void)fflush(stdout);
    while (!is_full && poll(&ready, 1, 0) > 0) {
        uint8_t byte;
        if (read(STDIN_FILENO, &byte, 1) != 1) {
            avr->state = cpu_Done;
            return 0;
        }
        avr_raise_irq(line, byte);
    }
    return when + avr_usec_to_cycles(avr, INTERVAL);
}

int main(int count, char **arguments) {
    static elf_firmware_t program;
    uint32_t flags = 0;
    avr_t *avr;
    int state = cpu_Running;
    avr_global_logger_set(log_errors);
    if (count != 2 || elf_read_firmware(arguments[1], &program) != 0) {
        return 2;
    }
    avr = avr_make_mcu_by_name("atmega328p");
    if (avr == NULL || avr_init(avr) != 0) {
        return 2;
    }
    avr->frequency = 16000000;
    avr_load_firmware(avr, &program);
    (void)avr_ioctl(avr, AVR_IOCTL_UART_SET_FLAGS('0'), &flags);
    line = avr_io_getirq(avr, AVR_IOCTL_UART_GETIRQ('0'), UART_IRQ_INPUT);
    avr_irq_register_notify(line + UART_IRQ_OUTPUT, output, NULL);
    avr_irq_register_notify(line + UART_IRQ_OUT_XON, set_full, NULL);
    avr_irq_register_notify(line + UART_IRQ_OUT_XOFF, set_full, &is_full);
    avr_cycle_timer_register_usec(avr, INTERVAL, transfer, NULL);
    while (state != cpu_Done && state != cpu_Crashed) {
        state = avr_run(avr);
    }
    return state == cpu_Crashed;
}
