/* Registers of every Cortex-M, and the functions that handle a board's interrupts. */
#ifndef CORTEX_M_H
#define CORTEX_M_H

#include MACHINE_HEADER

#include <stdint.h>

#define REGISTER(address) (*(volatile uint32_t *)(address))
#define SYST_CSR REGISTER(0xE000E010u)                        /* SysTick: control, */
#define SYST_RVR REGISTER(0xE000E014u)                        /* where it begins anew, */
#define SYST_CVR REGISTER(0xE000E018u)                        /* where it is */
#define NVIC_ISER(n) REGISTER(0xE000E100u + 4u * ((n) / 32u)) /* enables interrupts, a bit each */
#define NVIC_ICER(n) REGISTER(0xE000E180u + 4u * ((n) / 32u)) /* and disables them */
#define ICSR REGISTER(0xE000ED04u)                            /* bit 26: SysTick's exception waits */
#define AIRCR REGISTER(0xE000ED0Cu)                           /* reset */
#define CPACR REGISTER(0xE000ED88u) /* access to the coprocessors, of which 10 and 11 are the FPU */

static inline void enable_interrupt(uint32_t number) { NVIC_ISER(number) = 1u << number % 32u; }

static inline void disable_interrupt(uint32_t number) { NVIC_ICER(number) = 1u << number % 32u; }

static inline void interrupts_off(void) { __asm__ volatile("cpsid i" ::: "memory"); }
static inline void interrupts_on(void) { __asm__ volatile("cpsie i" ::: "memory"); }

void uart_interrupt(void);
void timer_interrupt(void);

#endif
