/** Bits, CRC and lines: what frames of every network of innervate are made with. */
#ifndef INNERVATE_WIRE_H
#define INNERVATE_WIRE_H

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/** A place in a frame's bytes, bit by bit, most significant first. */
typedef struct {
    uint8_t *data;
    int32_t at; /* bits from the beginning */
} innervate_bits_t;

/** Writes the lowest `bits` (1 to 31) of a value; the place holds zeros before. */
void innervate_put(innervate_bits_t *place, int32_t bits, int32_t value);

/** Reads `bits` (1 to 31) as a number that is never negative. */
int32_t innervate_get(const uint8_t *data, int32_t *at, int32_t bits);

/** The same as two's complement. */
int32_t innervate_get_signed(const uint8_t *data, int32_t *at, int32_t bits);

/** CRC-16/CCITT-FALSE of `count` bytes. */
uint16_t innervate_crc(const uint8_t *data, int32_t count);

/** Puts the CRC of what is in front into the last two of `size` bytes. */
void innervate_seal_crc(uint8_t *data, int32_t size);

/** 1 if the last two of `size` bytes, at least two, are the CRC of the others. */
int32_t innervate_is_sound(const uint8_t *data, int32_t size);

/** Byte stuffing (COBS) of `count` bytes, up to 253, with a zero behind: what goes out on a line.
 * `data` may be `line + 1`. Returns how many bytes that are: count + 2. */
int32_t innervate_stuff(const uint8_t *data, int32_t count, uint8_t *line);

/** Undoes it in place, without the zero; returns how many bytes are left, -1 if it was none. */
int32_t innervate_unstuff(uint8_t *line, int32_t count);

#ifdef __cplusplus
}
#endif

#endif /* INNERVATE_WIRE_H */
