/* Plays a script of calls on nodes in C (script.py), and says hashes of all that came of them.
 *
 * The script is a file of the host's, read by semihosting on emulated boards. LIFE stands for calls
 * that are drawn here as play.py draws them. TICKS: of a timer on boards, counted while handlers
 * run. */
#include "role.h"
#pragma GCC optimize("O2") /* also where handlers are made as small as they go */

#define NODES 16
#define MASK30 0x3FFFFFFF
#define PRIME 16777619U
#define P2 (PRIME * PRIME)
#define MIXED(word) ((word) ^ ((word) >> 15))
#define LONGEST_US 50000
enum { START, FRAME, TIMER, INPUT, CARRIER, END, STATE, PARAMS, GATE, SAY, BEGIN, LIFE,
    KEEP_STATE, KEEP_PARAMS, KEEP_GATE, KEEP_FRAME, KEEP_ITEM };

typedef struct {
    uint8_t what, node, zero[2];
    int32_t now, a, b;
} row_t;

/* Records as words, of which a hash is made. */
#define WORDS(type) ((sizeof(type) + 3) / 4)
typedef union {
    role_state_t is;
    uint32_t word[WORDS(role_state_t)];
} state_t;

static state_t states[NODES], kept_states[KEPT_STATE];
static role_params_t params, kept_params[KEPT_PARAMS];
static role_out_t out;
static role_item_t item;
static struct {
    int32_t number;
    role_item_t is;
} kept_items[KEPT_ITEM];
static int32_t state_count, params_count, frame_count, item_count;
#ifdef HAS_FRAME
static role_frame_t frame;
static struct {
    int32_t number;
    role_frame_t is;
} kept_frames[KEPT_FRAME];
#define HEARD &frame
#else
#define HEARD 0
#endif
#ifdef HAS_GATE
typedef union {
    role_gate_t is;
    uint32_t word[WORDS(role_gate_t)];
} gate_t;
static gate_t gates[NODES], kept_gate;
static uint8_t leads[NODES];
#define WHO &states[row.node].is, leads[row.node] ? &gates[row.node].is : 0
#else
#define WHO &states[row.node].is
#endif
static uint32_t mark = 1, sum, chance, calls[5], ticks[5];
static int32_t due[TIMERS];
static uint8_t is_set[TIMERS];

int read_script(void *to, uint32_t count);
void say(const char *text);
uint32_t tick_count(void);
void start_board(void);

static void fold(uint32_t word)
{
    sum = sum * PRIME + MIXED(word);
}

/* fold() for words that lie one after the other; four at a time, as one waits for the other. */
static void fold_all(const uint32_t *words, uint32_t count)
{
    uint32_t here = sum, i = 0;
    for (; i + 3 < count; i += 4) {
        here = here * (P2 * P2) + MIXED(words[i]) * (P2 * PRIME) + MIXED(words[i + 1]) * P2 +
               MIXED(words[i + 2]) * PRIME + MIXED(words[i + 3]);
    }
    for (; i < count; i++) {
        here = here * PRIME + MIXED(words[i]);
    }
    sum = here;
}

#ifdef HAS_FRAME
static void fold_frame(const role_frame_t *frame)
{
    fold(frame->kind);
    switch (frame->kind) {
FOLD_FRAME
    default:
        break;
    }
}
#endif

static void fold_out(void)
{
    fold(out.count);
    fold(out.overflow);
    for (int32_t i = 0; i < out.count; i++) {
        fold((uint32_t)out.action[i].kind);
        fold((uint32_t)out.action[i].a);
        fold((uint32_t)out.action[i].b);
        fold((uint32_t)out.action[i].c);
#ifdef HAS_FRAME
        if (role_frame_of(&out, i)) {
            fold_frame(role_frame_of(&out, i));
        }
#endif
    }
}

/* What came of a call, after all that came before. */
static void fold_call(uint32_t node)
{
    sum = 0;
    fold_all(states[node].word, WORDS(role_state_t));
#ifdef HAS_GATE
    if (leads[node]) {
        fold_all(gates[node].word, WORDS(role_gate_t));
    }
#endif
    fold_out();
    mark = (mark ^ sum) * PRIME;
}

static void call(row_t row)
{
    role_clear(&out);
    const uint32_t begun = tick_count();
    switch (row.what) {
    case START:
        role_on_start(WHO, &params, row.now, row.a, &out);
        break;
    case FRAME:
        role_on_frame(WHO, &params, row.now, row.a, HEARD, &out);
        break;
    case TIMER:
        role_on_timer(WHO, &params, row.now, row.a, &out);
        break;
    case INPUT:
        role_on_input(WHO, &params, row.now, row.a, &item, &out);
        break;
    default:
#ifdef HAS_CARRIER
        role_on_carrier(WHO, &params, row.now, row.a, row.b, &out);
#endif
        break;
    }
    ticks[row.what] += begun - tick_count();
    calls[row.what]++;
    fold_call(row.node);
}

static uint32_t below(uint32_t count)
{
    chance ^= chance << 13;
    chance ^= chance >> 17;
    chance ^= chance << 5;
    return chance % count;
}

/* The timer that is due first, and in `wait` how long until then; -1 = none is set. */
static int32_t first_due(int32_t now, int32_t *wait)
{
    int32_t first = -1;
    for (int32_t i = 0; i < TIMERS; i++) {
        const int32_t until = (due[i] - now) & MASK30;
        if (is_set[i] && (first < 0 || until < *wait)) {
            *wait = until;
            first = i;
        }
    }
    if (first >= 0 && *wait > MASK30 >> 1) {
        *wait = 0; /* overdue */
    }
    return first;
}

/* What happens next, and when: a timer that is due, or something before it. */
static void next(row_t *row)
{
    int32_t wait = LONGEST_US;
    const int32_t first = first_due(row->now, &wait);
    if (first >= 0 && below(100) < 35) {
        is_set[first] = 0;
        *row = (row_t){TIMER, 0, {0, 0}, (row->now + wait) & MASK30, first, 0};
        return;
    }
    wait = wait < LONGEST_US ? wait : LONGEST_US;
    row->now = (row->now + (int32_t)below((uint32_t)wait + 1)) & MASK30;
    const uint32_t what = below(1000);
    if (what < 4) {
        for (int32_t i = 0; i < TIMERS; i++) {
            is_set[i] = 0;
        }
        row->what = START;
        row->a = (int32_t)below(2);
#ifdef HAS_CARRIER
    } else if (what < 300) {
        row->what = CARRIER;
        row->a = (int32_t)below(2);
        row->b = (int32_t)below(2);
#endif
    } else if (item_count > 0 && (what < 500 || frame_count == 0)) {
        const uint32_t i = below((uint32_t)item_count);
        row->what = INPUT;
        row->a = kept_items[i].number;
        item = kept_items[i].is;
    } else {
#ifdef HAS_FRAME
        const uint32_t i = below((uint32_t)frame_count);
        row->what = FRAME;
        row->a = kept_frames[i].number;
        frame = kept_frames[i].is;
#endif
    }
}

/* A node from its start on, told what others were told. */
static void live(uint32_t seed, int32_t count)
{
    chance = seed * 2654435761U;
    states[0] = kept_states[below((uint32_t)state_count)];
    params = kept_params[below((uint32_t)params_count)];
#ifdef HAS_GATE
    below(1);
    gates[0] = kept_gate;
    leads[0] = 1;
#endif
    for (int32_t i = 0; i < TIMERS; i++) {
        is_set[i] = 0;
    }
    row_t row = {START, 0, {0, 0}, (int32_t)below(MASK30), 0, 0};
    row.a = (int32_t)below(2);
    for (int32_t i = 0; i < count; i++) {
        call(row);
        for (int32_t k = 0; k < out.count; k++) {
            if (out.action[k].kind == ROLE_SET_TIMER) {
                due[out.action[k].a % TIMERS] = out.action[k].b;
                is_set[out.action[k].a % TIMERS] = 1;
            }
        }
        next(&row);
    }
}

static void say_number(uint32_t number)
{
    char text[10] = "00000000 ";
    for (int i = 7; i >= 0; i--, number >>= 4) {
        text[i] = "0123456789abcdef"[number & 15U];
    }
    say(text);
}

/* Reads what stands behind a row. */
static void take(row_t row)
{
    switch (row.what) {
    case STATE:
        read_script(&states[row.node].is, sizeof(role_state_t));
#ifdef HAS_GATE
        leads[row.node] = 0;
        break;
    case GATE:
        leads[row.node] = 1;
        read_script(&gates[row.node].is, sizeof(role_gate_t));
        break;
    case KEEP_GATE:
        read_script(&kept_gate.is, sizeof(role_gate_t));
#endif
        break;
    case PARAMS:
        read_script(&params, sizeof params);
        break;
    case KEEP_STATE:
        read_script(&kept_states[state_count++].is, sizeof(role_state_t));
        break;
    case KEEP_PARAMS:
        read_script(&kept_params[params_count++], sizeof params);
        break;
#ifdef HAS_FRAME
    case FRAME:
        read_script(&frame, sizeof frame);
        break;
    case KEEP_FRAME:
        kept_frames[frame_count].number = row.a;
        read_script(&kept_frames[frame_count++].is, sizeof frame);
        break;
#endif
    case INPUT:
        read_script(&item, sizeof item);
        break;
    case KEEP_ITEM:
        kept_items[item_count].number = row.a;
        read_script(&kept_items[item_count++].is, sizeof item);
        break;
    default:
        break;
    }
}

int main(void)
{
    row_t row;
    start_board();
    while (read_script(&row, sizeof row) && row.what != END) {
        take(row);
        if (row.what <= CARRIER) {
            call(row);
        } else if (row.what == LIFE) {
            live((uint32_t)row.a, row.b);
        } else if (row.what == BEGIN) {
            mark = 1;
        } else if (row.what == SAY) {
            say_number(mark);
        }
    }
    for (int i = 0; i < 5; i++) {
        say_number(calls[i]);
        say_number(ticks[i]);
    }
    say("\n");
    return 0;
}
