/* ATmega328P with 16 MHz: serial line of 500,000 baud, and a tick of 10 ms. */
#include <avr/interrupt.h>
#include <avr/io.h>
#include <avr/sleep.h>

#include "block.h"
#include "processor.h"

static volatile uint8_t ticks;

ISR(TIMER1_COMPA_vect) {
    ticks++;
}

/* A byte has arrived. On hardware, store it here: the UART has room for two bytes. */
ISR(USART_RX_vect) {
    UCSR0B &= (uint8_t)~(1u << RXCIE0);
}

uint8_t port_clock(void) {
    return ticks;
}

void processor_start(void) {
    UCSR0A = 1u << U2X0;
    UBRR0 = 3;
    UCSR0B = (1u << RXEN0) | (1u << TXEN0);
    OCR1A = 2499;
    TCCR1B = (1u << WGM12) | (1u << CS11) | (1u << CS10);
    TIMSK1 = 1u << OCIE1A;
    sei();
}

int16_t processor_read(void) {
    return (UCSR0A & (1u << RXC0)) != 0u ? (int16_t)UDR0 : (int16_t)-1;
}

void processor_write(uint8_t byte) {
    while ((UCSR0A & (1u << UDRE0)) == 0u) {
    }
    UDR0 = byte;
}

void processor_rest(void) {
    UCSR0B |= 1u << RXCIE0;
    sleep_mode();
}
