/* Two nodes shake hands and seal a frame; says how many ticks each part took. */
#include "crypto/innervate_example.h"
#include "innervate_contact.h"

void say(const char *text);
uint32_t tick_count(void);
void start_board(void);
int main(void);

static innervate_contact_t asks, answers;
static uint8_t question[INNERVATE_SAY_MAX], answer[INNERVATE_SAY_MAX], said[INNERVATE_SAY_MAX];

/* No chance: that what is counted is the same in every run. */
static void count_up(uint8_t *out, int32_t count)
{
    static uint8_t state;
    for (int32_t i = 0; i < count; i++) {
        out[i] = state;
        state = (uint8_t)(state + 37U);
    }
}

static const innervate_crypto_t crypto = {0, innervate_example_close, innervate_example_open,
        innervate_example_x25519, innervate_example_sha256, innervate_example_blake2s, count_up};
static const innervate_keys_t keys = {&crypto, 1, {1, 2, 3}};

static void say_ticks(uint32_t begun)
{
    const uint32_t ticks = begun - tick_count();
    char text[10] = "00000000 ";
    for (int i = 0; i < 8; i++) {
        text[7 - i] = "0123456789abcdef"[ticks >> (4 * i) & 15U];
    }
    say(text);
}

int main(void)
{
    const uint8_t life[INNERVATE_LIFE] = {1};
    uint8_t frame[INNERVATE_SEAL_MORE + 20] = {0};
    int32_t count, size, who;
    start_board();
    innervate_contact_begin(&asks, &keys, 2, 1, life);
    innervate_contact_begin(&answers, &keys, 2, 2, life);
    uint32_t begun = tick_count();
    size = innervate_contact_beat(&asks, 0, question);
    say_ticks(begun);
    begun = tick_count();
    innervate_contact_take(&answers, question, size, answer, &count, &who);
    say_ticks(begun);
    begun = tick_count();
    innervate_contact_take(&asks, answer, count, said, &size, &who);
    say_ticks(begun);
    innervate_contact_take(&answers, said, size, answer, &count, &who);
    begun = tick_count();
    size = innervate_contact_close(&asks, frame, 20);
    say_ticks(begun);
    begun = tick_count();
    size = innervate_contact_take(&answers, frame, size, said, &count, &who);
    say_ticks(begun);
    say(size == 20 ? "ok\n" : "nothing came\n");
    return 0;
}
