/* Plays a script of calls on nodes in C, and says a hash of all that came of them.
 *
 * A row is 16 bytes (what, node, 0, 0, clock, a, b, numbers of 4 bytes), then perhaps a record. The
 * script is a file of the host's, read by semihosting on emulated boards. TICKS: of a timer there,
 * counted while handlers run. */
#include "role.h"

#define NODES 16
enum { START, FRAME, TIMER, INPUT, CARRIER, END, STATE, PARAMS, GATE };

typedef struct {
    uint8_t what, node, zero[2];
    int32_t now, a, b;
} row_t;

static role_state_t states[NODES];
static role_params_t params;
static role_out_t out;
#ifdef HAS_FRAME
static role_frame_t frame;
#endif
static role_item_t item;
#ifdef HAS_GATE
static role_gate_t gates[NODES];
static uint8_t leads[NODES];
#define WHO &states[row.node], leads[row.node] ? &gates[row.node] : 0
#else
#define WHO &states[row.node]
#endif
static uint32_t mark = 1, calls[5], ticks[5];

int read_script(void *to, uint32_t count);
void say(const char *text);
uint32_t tick_count(void);
void start_board(void);

static void fold(const void *data, uint32_t count)
{
    for (uint32_t i = 0; i < count; i++) {
        mark = (mark ^ ((const uint8_t *)data)[i]) * 16777619U;
    }
}

static void fold_out(void)
{
    const uint8_t head[2] = {out.count, out.overflow};
    fold(head, 2);
    for (int32_t i = 0; i < out.count; i++) {
        const int32_t action[4] = {out.action[i].kind, out.action[i].a, out.action[i].b,
                out.action[i].c};
        fold(action, sizeof action);
#ifdef HAS_FRAME
        if (role_frame_of(&out, i)) {
            fold(role_frame_of(&out, i), sizeof frame);
        }
#endif
    }
    role_clear(&out);
}

static void call(row_t row)
{
    const uint32_t begun = tick_count();
    switch (row.what) {
    case START:
        role_on_start(WHO, &params, row.now, row.a, &out);
        break;
    case FRAME:
#ifdef HAS_FRAME
        role_on_frame(WHO, &params, row.now, row.a, &frame, &out);
#else
        role_on_frame(WHO, &params, row.now, row.a, 0, &out);
#endif
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
    fold(&states[row.node], sizeof states[0]);
    fold_out();
}

static void say_number(uint32_t number)
{
    char text[10] = "00000000 ";
    for (int i = 7; i >= 0; i--, number >>= 4) {
        text[i] = "0123456789abcdef"[number & 15U];
    }
    say(text);
}

int main(void)
{
    row_t row;
    start_board();
    while (read_script(&row, sizeof row) && row.what != END) {
        if (row.what == STATE) {
            read_script(&states[row.node], sizeof states[0]);
        } else if (row.what == PARAMS) {
            read_script(&params, sizeof params);
        } else if (row.what == GATE) {
#ifdef HAS_GATE
            leads[row.node] = 1;
            read_script(&gates[row.node], sizeof gates[0]);
#endif
        } else {
            if (row.what == FRAME) {
#ifdef HAS_FRAME
                read_script(&frame, sizeof frame);
#endif
            } else if (row.what == INPUT) {
                read_script(&item, sizeof item);
            }
            call(row);
        }
    }
    say_number(mark);
    for (int i = 0; i < 5; i++) {
        say_number(calls[i]);
        say_number(ticks[i]);
    }
    say("\n");
    return 0;
}
