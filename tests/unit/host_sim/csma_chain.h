/* Unslotted CSMA/CA of n saturated motes that all hear each other, as a chain from one silence of the channel to the next.
 *
 * Time is cut into bins of 32 us. When the channel has been silent for one assessment, m motes have just sent and wait in their first backoff, all but the
 * last one of them for a lag less; the others wait in whatever backoff they have come to. Motes of one kind are taken as independent and alike. From the
 * distributions of backoff and remaining wait of both kinds follow, bin by bin, the probability that the first assessment ends there, how many more end
 * within the turnaround after it, which send too, and what is left of the waits of those who do not. These then find the channel busy until it has been silent
 * again, which gives the distribution of the next cycle. The fixed point of this map, weighted with the probability of m, is the model. It knows that those who
 * have collided start again together, which a constant rate of assessments does not. */
#ifndef MOTEHOUND_TESTS_CSMA_CHAIN_H
#define MOTEHOUND_TESTS_CSMA_CHAIN_H

#include <math.h>
#include <stddef.h>
#include <string.h>

enum {
    CHAIN_MOTES = 50,
    CHAIN_STAGES = 5,
    CHAIN_TURN = 6,  /* 192 us */
    CHAIN_SENSE = 4, /* 128 us */
    CHAIN_UNIT = 10, /* 320 us */
    CHAIN_WAIT = 31 * CHAIN_UNIT + CHAIN_SENSE + 1,
    CHAIN_CYCLES = 30
};

static const unsigned chain_windows[CHAIN_STAGES] = {8, 16, 32, 32, 32};

/* Probability of each backoff and remaining wait in bins. */
struct chain_waits {
    double p[CHAIN_STAGES][CHAIN_WAIT];
};

/* The same by wait alone: of one bin, from it on. */
struct chain_marginal {
    double at[CHAIN_WAIT + CHAIN_TURN + 1], from[CHAIN_WAIT + CHAIN_TURN + 1];
};

static void chain_add(struct chain_waits *to, const struct chain_waits *what, double weight)
{
    for (int k = 0; k < CHAIN_STAGES; k++) {
        for (int r = 0; r < CHAIN_WAIT; r++) {
            to->p[k][r] += weight * what->p[k][r];
        }
    }
}

/* A mote that has sent, `lag` bins before the last one to end: if it assesses too early, it finds that one. */
static void chain_add_fresh(struct chain_waits *to, int lag, double weight)
{
    for (unsigned j = 0; j < chain_windows[0]; j++) {
        const int wait = (int)j * CHAIN_UNIT - lag;
        const double share = weight / chain_windows[0];
        if (wait >= 0) {
            to->p[0][wait] += share;
        } else {
            for (unsigned i = 0; i < chain_windows[1]; i++) {
                const int left = wait + CHAIN_SENSE + (int)i * CHAIN_UNIT; /* below 0: due a bin ago, so now */
                to->p[1][left > 0 ? left : 0] += share / chain_windows[1];
            }
        }
    }
}

/* One bin of a busy channel: who assesses it backs off further, after five times with the next frame. */
static void chain_step(struct chain_waits *waits)
{
    for (int k = 0; k < CHAIN_STAGES; k++) {
        const double due = waits->p[k][0];
        memmove(waits->p[k], waits->p[k] + 1, (CHAIN_WAIT - 1) * sizeof waits->p[k][0]);
        waits->p[k][CHAIN_WAIT - 1] = 0;
        for (unsigned i = 0, next = ((unsigned)k + 1) % CHAIN_STAGES; i < chain_windows[next]; i++) {
            /* a later stage has not moved on in this step yet, so it is put one bin further */
            const int wait = CHAIN_SENSE - 1 + (int)i * CHAIN_UNIT + (next > (unsigned)k);
            waits->p[next][wait] += due / chain_windows[next];
        }
    }
}

static struct chain_marginal chain_marginal(const struct chain_waits *waits)
{
    struct chain_marginal marginal = {{0}, {0}};
    for (int r = CHAIN_WAIT - 1; r >= 0; r--) {
        for (int k = 0; k < CHAIN_STAGES; k++) {
            marginal.at[r] += waits->p[k][r];
        }
        marginal.from[r] = marginal.from[r + 1] + marginal.at[r];
    }
    return marginal;
}

/* Coefficients of (a + b z)^n. */
static void chain_power(double a, double b, unsigned n, double *coefficients)
{
    memset(coefficients, 0, (CHAIN_MOTES + 1) * sizeof *coefficients);
    coefficients[0] = 1;
    for (unsigned i = 1; i <= n; i++) {
        for (unsigned j = i; j > 0; j--) {
            coefficients[j] = a * coefficients[j] + b * coefficients[j - 1];
        }
        coefficients[0] *= a;
    }
}

/* One kind of mote about bin t: waits that end in it, later within the turnaround, after it. */
struct chain_kind {
    unsigned motes;
    double now, soon, later;
};

static struct chain_kind chain_kind(const struct chain_marginal *waits, int t, unsigned motes)
{
    struct chain_kind kind = {.motes = motes, .now = waits->at[t], .soon = 0.5 * waits->at[t + CHAIN_TURN]};
    for (int i = 1; i < CHAIN_TURN; i++) {
        kind.soon += waits->at[t + i];
    }
    kind.later = fmax(waits->from[t] - kind.now - kind.soon, 0);
    return kind;
}

struct chain {
    unsigned motes;
    struct chain_waits others, survivors;
    double senders[CHAIN_MOTES + 1], next_senders[CHAIN_MOTES + 1]; /* probability of how many send in a cycle */
    double lag[CHAIN_TURN + 1], next_lag[CHAIN_TURN + 1];
    double first; /* mean bin of the first assessment */
};

/* Those of one kind who do not send, if the first of `a` and `b` (which do not count the mote itself) assesses in bin t. */
static void chain_survive(struct chain *chain, const struct chain_waits *waits, int t, double weight,
                          const struct chain_kind *a, const struct chain_kind *b)
{
    const double somebody = pow(a->now + a->soon + a->later, a->motes) * pow(b->now + b->soon + b->later, b->motes) -
                            pow(a->soon + a->later, a->motes) * pow(b->soon + b->later, b->motes);
    for (int k = 0; k < CHAIN_STAGES && somebody > 0; k++) {
        for (int r = t + CHAIN_TURN; r < CHAIN_WAIT; r++) {
            const double half = r == t + CHAIN_TURN ? 0.5 : 1;
            chain->survivors.p[k][r - t - CHAIN_TURN] += weight * somebody * half * waits->p[k][r];
        }
    }
}

static void chain_bin(struct chain *chain, int t, double weight, const struct chain_waits waits[2],
                      const struct chain_marginal marginals[2], unsigned fresh)
{
    const struct chain_kind kinds[2] = {chain_kind(&marginals[0], t, fresh),
                                        chain_kind(&marginals[1], t, chain->motes - fresh)};
    double all[2][CHAIN_MOTES + 1], not_now[2][CHAIN_MOTES + 1], number[CHAIN_MOTES + 1] = {0}, total = 0;
    for (int i = 0; i < 2; i++) {
        chain_power(kinds[i].later, kinds[i].now + kinds[i].soon, kinds[i].motes, all[i]);
        chain_power(kinds[i].later, kinds[i].soon, kinds[i].motes, not_now[i]);
    }
    for (unsigned i = 0; i <= kinds[0].motes; i++) {
        for (unsigned j = 0; j <= kinds[1].motes; j++) {
            number[i + j] += weight * (all[0][i] * all[1][j] - not_now[0][i] * not_now[1][j]);
        }
    }
    for (unsigned i = 1; i <= chain->motes; i++) {
        chain->next_senders[i] += number[i];
        total += number[i];
    }
    chain->first += t * total;
    for (int i = 0; i <= CHAIN_TURN; i++) {
        const double ends = fresh * marginals[0].at[t + i] + (chain->motes - fresh) * marginals[1].at[t + i];
        chain->next_lag[i] += (total - number[1]) * ends * (i == 0 || i == CHAIN_TURN ? 0.5 : 1);
    }
    for (int i = 0; i < 2; i++) {
        struct chain_kind left[2] = {kinds[0], kinds[1]};
        if (left[i].motes > 0) {
            left[i].motes--;
            chain_survive(chain, &waits[i], t, weight * kinds[i].motes, &left[0], &left[1]);
        }
    }
}

static void chain_normalise(double *p, size_t count)
{
    double sum = 0;
    for (size_t i = 0; i < count; i++) {
        sum += p[i];
    }
    for (size_t i = 0; i < count && sum > 0; i++) {
        p[i] /= sum;
    }
}

/* One cycle: from the waits at silence to those at the next one. */
static void chain_cycle(struct chain *chain, int air)
{
    struct chain_waits waits[2];
    struct chain_marginal marginals[2];
    memset(&chain->survivors, 0, sizeof chain->survivors);
    memset(chain->next_senders, 0, sizeof chain->next_senders);
    memset(chain->next_lag, 0, sizeof chain->next_lag);
    chain->first = 0;
    waits[1] = chain->others;
    marginals[1] = chain_marginal(&waits[1]);
    for (unsigned fresh = 1; fresh <= chain->motes; fresh++) {
        if (chain->senders[fresh] < 1e-7) {
            continue;
        }
        memset(&waits[0], 0, sizeof waits[0]);
        chain_add_fresh(&waits[0], 0, 1.0 / fresh);
        for (int lag = 0; lag <= CHAIN_TURN && fresh > 1; lag++) {
            chain_add_fresh(&waits[0], lag, (1 - 1.0 / fresh) * chain->lag[lag]);
        }
        marginals[0] = chain_marginal(&waits[0]);
        for (int t = 0; t < CHAIN_WAIT; t++) {
            if (pow(marginals[0].from[t], fresh) * pow(marginals[1].from[t], chain->motes - fresh) < 1e-10) {
                break;
            }
            chain_bin(chain, t, chain->senders[fresh], waits, marginals, fresh);
        }
    }
    memcpy(chain->senders, chain->next_senders, sizeof chain->senders);
    memcpy(chain->lag, chain->next_lag, sizeof chain->lag);
    chain_normalise(chain->senders, CHAIN_MOTES + 1);
    chain_normalise(chain->lag, CHAIN_TURN + 1);
    struct chain_waits busy = chain->survivors;
    for (int i = 0; i < air + CHAIN_SENSE; i++) {
        chain_step(&busy);
    }
    memset(&chain->others, 0, sizeof chain->others);
    chain_add(&chain->others, &busy, chain->senders[1]);
    for (int lag = 0; lag <= CHAIN_TURN; lag++) {
        chain_add(&chain->others, &busy, (1 - chain->senders[1]) * chain->lag[lag]);
        chain_step(&busy);
    }
    chain_normalise(&chain->others.p[0][0], CHAIN_STAGES * CHAIN_WAIT);
}

/* Share of the time with frames that nobody disturbs, and share of the frames that are disturbed. `air`: of a frame, in bins. */
static void chain_solve(unsigned motes, int air, double *throughput, double *collisions)
{
    struct chain chain = {.motes = motes, .senders = {0, 1}, .lag = {1}};
    double senders = 0, lag = 0;
    chain_add_fresh(&chain.others, 0, 1);
    for (int i = 0; i < CHAIN_CYCLES; i++) {
        chain_cycle(&chain, air);
    }
    for (unsigned i = 1; i <= motes; i++) {
        senders += i * chain.senders[i];
    }
    for (int i = 0; i <= CHAIN_TURN; i++) {
        lag += i * chain.lag[i];
    }
    *throughput =
        chain.senders[1] * air / (chain.first + CHAIN_TURN + air + CHAIN_SENSE + (1 - chain.senders[1]) * lag);
    *collisions = 1 - chain.senders[1] / senders;
}

#endif
