/* The protocol "prince - exception - competition" (motehound/prince.h) for one target, as it looks to a model checker. README.md says what is modelled, what is
 * not, and how to check it.
 *
 * NODES nodes, each of which hears those at most REACH away in number. Time goes in rounds of about a second; who acts first in a round is free, and so is
 * whether a back-off lasts into the next. What is sent is heard at once by all near, but for up to LOSSES receptions, whichever. What the target does is free:
 * every LEG rounds it is detected by another two nodes that hear each other, whatever was predicted. What heads predict is free: which node is prince, or
 * that nobody is, and which class every other node finds itself in.
 *
 * There is no end of time: numbers of generations are kept relative to the oldest one that is known. */

#ifndef NODES
#define NODES 3
#endif
#ifndef REACH
#define REACH NODES
#endif
#ifndef LOSSES
#define LOSSES 1
#endif

/* Properties, in rounds. */
#ifndef SEVERAL_MAX
#define SEVERAL_MAX (ENTRY + WATCHDOG) /* with more than one head: a generation */
#endif
#ifndef BLIND_MAX
#define BLIND_MAX (10 + 7 * LOSSES) /* without a fix while one who watches detects the target, and so does another whom it hears */
#endif

/* Times, in rounds. */
#define LEG 4       /* the same nodes detect the target */
#define ENTRY 2     /* from a fix until the prince is to detect the target */
#define GUARD 1     /* from then until a regent steps in */
#define WATCHDOG 3  /* from then until the head gives up */
#define STAY 12     /* from a fix until members sleep again */
#define STAY_FAIL 10/* from a failure until who has heard of it sleeps */
#define STAY_OLD 3  /* from leading, or a lost query, until it sleeps */
#define LONGER 2    /* who detects the target when its time is over */
#define HOLD 1      /* after a lost competition until it contends again */
#define RELAY 2     /* between two reports of failure of the same node */

/* Each guard can be taken out. */
#ifdef NO_EXCEPTION
#define EXCEPTION false
#else
#define EXCEPTION true
#endif
#ifdef NO_REGENT
#define REGENT false
#else
#define REGENT true
#endif
#ifdef NO_WATCHDOG
#define DOG false
#else
#define DOG true
#endif
#ifdef NO_RETRY
#define RETRY false
#else
#define RETRY true
#endif
#ifdef NO_RELAY
#define RELAYS false
#else
#define RELAYS true
#endif
#ifdef NO_LINGER
#define LINGER false
#else
#define LINGER true
#endif
#ifdef NO_REPEAT
#define REPEAT false
#else
#define REPEAT true
#endif
#ifdef NO_YIELD
#define YIELD false
#else
#define YIELD true
#endif

mtype = {ASLEEP, WATCH, LOCATE, HEAD};               /* states */
mtype = {PRINCE, INNER, OUTER, COMPETITOR, PASSIVE}; /* what a watcher is */
mtype = {Awake, Query, Answer, Fail, Succeed, Compete};

typedef member {
    mtype state = WATCH;
    mtype part = COMPETITOR;
    byte generation;
    byte head;             /* that it knows, of this generation */
    byte left = STAY_FAIL; /* rounds until it sleeps; locator: until the answers are in; head: until the watchdog barks */
    byte wait;             /* rounds until a regent may step in, or a competitor may contend */
    byte relay;            /* rounds until it may report a failure again */
    bool quiet;            /* has heard a query in this round or the last */
    bool answered;         /* locator */
    bool again;            /* locator: this is the second try */
    bool contest;          /* locator: after a competition */
    bool contends;
    bool waited            /* a round's back-off */
};

member m[NODES];
chan air[NODES] = [6] of {mtype, byte, byte, byte}; /* kind, sender, generation, and for an Awake the prince, for an Answer to whom */
bool detects[NODES];
bool todo[NODES]; /* may have its turn in this round */
byte phase, losses = LOSSES;
byte several, blind;
bool fixed; /* in this round */

#define NEAR(i, j) (i != j && i <= j + REACH && j <= i + REACH)
#define FIRST(i) ((i < 1 || empty(air[0])) && (i < 2 || empty(air[1])) && (i < 3 || empty(air[2 % NODES])))
#define SILENT (FIRST(NODES - 1) && empty(air[NODES - 1]))

/* Is there anything for i to do in its turn? */
#define DUE(i)                                                                                                         \
    (m[i].state != ASLEEP &&                                                                                           \
     (m[i].left == 0 || (m[i].state == WATCH && detects[i] && !m[i].quiet && m[i].wait == 0 && m[i].part != PASSIVE)))

inline send(what, sender, era, extra)
{
    printf("  node %d: %e %d (%d)\n", sender, what, era, extra);
    for (k : 0 .. NODES - 1) {
        if
        :: NEAR(sender, k) && (what != Answer || k == extra) ->
            assert(nfull(air[k]));
            if
            :: air[k]!what, sender, era, extra
            :: losses > 0 -> losses--; printf("    lost to node %d\n", k)
            fi
        :: else
        fi
    }
    k = 0
}

inline become(i, a, b, rounds, pause)
{
    printf("  node %d is %e %e\n", i, a, b);
    m[i].state = a;
    m[i].part = b;
    m[i].left = rounds;
    m[i].wait = pause;
    m[i].answered = false;
    m[i].again = false;
    m[i].contest = false;
    m[i].contends = false;
    m[i].waited = false
}

inline sleep(i)
{
    become(i, ASLEEP, PASSIVE, 0, 0);
    m[i].generation = 0;
    m[i].head = 0;
    m[i].relay = 0;
    m[i].quiet = false
}

inline ask(i, second, rival)
{
    become(i, LOCATE, PASSIVE, 1, 0);
    m[i].again = second;
    m[i].contest = rival;
    send(Query, i, m[i].generation + 1, 0)
}

inline fail(i)
{
    become(i, WATCH, COMPETITOR, STAY_FAIL, 0);
    m[i].relay = RELAY;
    send(Fail, i, m[i].generation, 0)
}

/* Of the prince: the head itself stands for nobody. */
inline announce(i)
{
    select(choice : 0 .. NODES - 1);
    send(Awake, i, m[i].generation, choice);
    choice = 0
}

inline lead(i)
{
    become(i, HEAD, PASSIVE, ENTRY + WATCHDOG, 0);
    m[i].generation++;
    m[i].head = i;
    m[i].relay = 0;
    m[i].quiet = false;
    fixed = true;
    send(Succeed, i, m[i].generation, 0);
    announce(i)
}

/* The answers are in. */
inline close(i)
{
    if
    :: m[i].answered -> lead(i)
    :: !m[i].answered && m[i].contest && (!RELAYS || m[i].relay > 0) ->
        become(i, WATCH, COMPETITOR, STAY_FAIL, HOLD)
    :: !m[i].answered && m[i].contest && RELAYS && m[i].relay == 0 -> fail(i)
    :: !m[i].answered && !m[i].contest && RETRY && !m[i].again && detects[i] -> ask(i, true, false)
    :: !m[i].answered && !m[i].contest && (!RETRY || m[i].again || !detects[i]) -> fail(i)
    fi
}

/* Its time to watch is over. */
inline stop_watching(i)
{
    if
    :: LINGER && detects[i] -> m[i].part = COMPETITOR; m[i].left = LONGER
    :: else ->
        /* the last who knows of the target must not sleep when it detects it and hears another who does */
        others = 0;
        found = 0;
        for (k : 0 .. NODES - 1) {
            others = others + (k != i && m[k].state != ASLEEP);
            found = found + (NEAR(i, k) && detects[k])
        }
        assert(others > 0 || !detects[i] || found == 0);
        others = 0;
        found = 0;
        k = 0;
        sleep(i)
    fi
}

inline act(i)
{
    if
    :: m[i].state == LOCATE && m[i].left == 0 -> close(i)
    :: m[i].state == HEAD && m[i].left == 0 ->
        if
        :: DOG -> fail(i)
        :: else -> m[i].left = 1
        fi
    :: m[i].state == WATCH && m[i].left == 0 -> stop_watching(i)
    :: m[i].state == WATCH && m[i].left > 0 && detects[i] && !m[i].quiet && m[i].wait == 0 ->
        if
        :: m[i].part == PRINCE -> ask(i, false, false)
        :: m[i].part == OUTER && EXCEPTION -> ask(i, false, false)
        :: m[i].part == INNER && REGENT -> ask(i, false, false)
        :: m[i].part == COMPETITOR && m[i].contends -> ask(i, false, true)
        :: m[i].part == COMPETITOR && !m[i].contends -> m[i].contends = true; send(Compete, i, m[i].generation + 1, 0)
        :: !m[i].waited && m[i].part != PRINCE && m[i].part != PASSIVE && !m[i].contends -> m[i].waited = true
        :: else
        fi
    :: else -> m[i].contends = false
    fi
}

inline hear_awake(i, from, number, prince)
{
    if
    :: m[i].state == ASLEEP || number > m[i].generation ||
       (number == m[i].generation && (YIELD || m[i].state != HEAD) && from < m[i].head) ||
       (number == m[i].generation && m[i].state == WATCH && (m[i].part == PASSIVE || m[i].part == COMPETITOR)) ->
        if
        :: prince == i -> become(i, WATCH, PRINCE, STAY, 0)
        :: prince != i && prince != from -> become(i, WATCH, INNER, STAY, ENTRY + GUARD)
        :: prince == from -> become(i, WATCH, COMPETITOR, STAY, ENTRY)
        :: prince != i -> become(i, WATCH, OUTER, STAY, 0)
        :: prince != i -> sleep(i)
        fi;
        if
        :: m[i].state == WATCH -> m[i].generation = number; m[i].head = from
        :: else
        fi
    :: else
    fi
}

inline repeat(i)
{
    if
    :: REPEAT -> announce(i)
    :: else
    fi
}

inline hear_query(i, from, number)
{
    if
    :: m[i].state == HEAD && number <= m[i].generation -> repeat(i)
    :: m[i].state != ASLEEP && number > m[i].generation && !(m[i].state == LOCATE && number == m[i].generation + 1 && i < from) ->
        m[i].quiet = true;
        m[i].contends = false;
        if
        :: m[i].state == LOCATE -> become(i, WATCH, PASSIVE, STAY_OLD, 0)
        :: else
        fi;
        if
        :: detects[i] -> send(Answer, i, number, from)
        :: else
        fi
    :: else
    fi
}

inline hear_answer(i, number)
{
    if
    :: m[i].state == LOCATE && number == m[i].generation + 1 -> m[i].answered = true
    :: else
    fi
}

inline hear_fail(i, number)
{
    if
    :: m[i].state == HEAD && number < m[i].generation -> repeat(i)
    :: m[i].state == ASLEEP || (m[i].state != LOCATE && number >= m[i].generation) ->
        if
        :: number > m[i].generation -> m[i].head = NODES
        :: else
        fi;
        become(i, WATCH, COMPETITOR, STAY_FAIL, 0);
        m[i].generation = number
    :: else
    fi
}

inline hear_succeed(i, number)
{
    if
    :: m[i].state != ASLEEP && number > m[i].generation ->
        if
        :: m[i].state == WATCH && m[i].left > STAY_OLD -> m[i].part = PASSIVE; m[i].wait = 0; m[i].contends = false
        :: else -> become(i, WATCH, PASSIVE, STAY_OLD, 0)
        fi
    :: else
    fi
}

/* The higher number has the higher energy. */
inline hear_compete(i, from, number)
{
    if
    :: m[i].state == HEAD && number <= m[i].generation -> repeat(i)
    :: m[i].contends && from > i && number > m[i].generation -> m[i].contends = false; m[i].wait = HOLD
    :: else
    fi
}

active [NODES] proctype node()
{
    mtype kind = Awake;
    byte from, number, extra, choice, k, others, found;
end:
    do
    :: atomic { todo[_pid] && SILENT -> act(_pid); todo[_pid] = false }
    :: atomic {
        FIRST(_pid) && nempty(air[_pid]) -> air[_pid]?kind, from, number, extra;
        if
        :: kind == Awake -> hear_awake(_pid, from, number, extra)
        :: kind == Query -> hear_query(_pid, from, number)
        :: kind == Answer -> hear_answer(_pid, number)
        :: kind == Fail -> hear_fail(_pid, number)
        :: kind == Succeed -> hear_succeed(_pid, number)
        :: kind == Compete -> hear_compete(_pid, from, number)
        fi;
        kind = Awake;
        from = 0;
        number = 0;
        extra = 0
    }
    od
}

/* Counts the round that is over, and begins another. */
inline check()
{
    for (i : 0 .. NODES - 1) {
        heads = heads + (m[i].state == HEAD);
        for (j : 0 .. NODES - 1) {
            possible = possible || (NEAR(i, j) && detects[i] && detects[j] && m[i].state != ASLEEP)
        }
    }
    several = (heads > 1 -> several + 1 : 0);
    if
    :: fixed -> blind = 0
    :: !fixed && possible -> blind++
    :: else
    fi;
    assert(several <= SEVERAL_MAX);
    assert(blind <= BLIND_MAX);
    fixed = false;
    heads = 0;
    possible = false
}

inline count_down()
{
    oldest = 255;
    for (i : 0 .. NODES - 1) {
        if
        :: m[i].state != ASLEEP && m[i].generation < oldest -> oldest = m[i].generation
        :: else
        fi
    }
    for (i : 0 .. NODES - 1) {
        if
        :: m[i].state != ASLEEP ->
            m[i].generation = m[i].generation - oldest;
            m[i].left = m[i].left - (m[i].left > 0);
            m[i].wait = m[i].wait - (m[i].wait > 0);
            m[i].relay = m[i].relay - (m[i].relay > 0)
        :: else
        fi;
        todo[i] = DUE(i);
        m[i].quiet = false
    }
    oldest = 0;
    i = 0;
    j = 0
}

active proctype clock()
{
    byte i, j, heads, oldest;
    bool possible;
end:
    do
    :: atomic {
        SILENT && todo[0] + todo[1] + todo[NODES - 2] + todo[NODES - 1] == 0 ->
        d_step { check() }
        if
        :: phase == 0 ->
            select(i : 0 .. NODES - 1);
            i = (NEAR(i, (i + 1) % NODES) -> i : 0);
            d_step {
                for (j : 0 .. NODES - 1) {
                    detects[j] = (j == i || j == (i + 1) % NODES)
                }
            }
        :: else
        fi;
        d_step {
            phase = (phase + 1) % LEG;
            count_down();
            printf("round; detected by node 0: %d, 1: %d, ..., last: %d\n", detects[0], detects[1], detects[NODES - 1])
        }
    }
    od
}
