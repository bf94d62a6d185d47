/* Bits, CRC and lines (innervate/wire/bits.py, crc.py, cobs.py). */
#include "innervate_wire.h"

void innervate_put(innervate_bits_t *place, int32_t bits, int32_t value)
{
/*+ quick */
    if (((place->at | bits) & 7) == 0) { /* whole bytes */
        for (int32_t shift = bits - 8; shift >= 0; shift -= 8) {
            place->data[place->at >> 3] = (uint8_t)((uint32_t)value >> shift);
            place->at += 8;
        }
        return;
    }
/*- */
    for (int32_t bit = bits - 1; bit >= 0; bit--) {
        if (((uint32_t)value >> bit) & 1U) {
            uint8_t *byte = &place->data[place->at >> 3];
            *byte = (uint8_t)(*byte | (0x80U >> (place->at & 7)));
        }
        place->at++;
    }
}

int32_t innervate_get(const uint8_t *data, int32_t *at, int32_t bits)
{
    uint32_t value = 0;
/*+ quick */
    if (((*at | bits) & 7) == 0) { /* whole bytes */
        for (int32_t end = *at + bits; *at < end; *at += 8) {
            value = value << 8 | data[*at >> 3];
        }
        return (int32_t)value;
    }
/*- */
    for (int32_t i = 0; i < bits; i++) {
        value = value << 1 | ((uint32_t)data[*at >> 3] >> (7 - (*at & 7)) & 1U);
        (*at)++;
    }
    return (int32_t)value;
}

int32_t innervate_get_signed(const uint8_t *data, int32_t *at, int32_t bits)
{
    const int32_t half = (int32_t)1 << (bits - 1);
    return (innervate_get(data, at, bits) ^ half) - half;
}

uint16_t innervate_crc(const uint8_t *data, int32_t count)
{
    uint32_t crc = 0xFFFF;
/*+ quick */
    static const uint16_t four[16] = { /* what four bits make of a CRC */
        0x0000, 0x1021, 0x2042, 0x3063, 0x4084, 0x50A5, 0x60C6, 0x70E7,
        0x8108, 0x9129, 0xA14A, 0xB16B, 0xC18C, 0xD1AD, 0xE1CE, 0xF1EF,
    };
    for (int32_t i = 0; i < count; i++) {
        crc = (crc << 4 & 0xFFFFU) ^ four[(crc >> 12) ^ (data[i] >> 4)];
        crc = (crc << 4 & 0xFFFFU) ^ four[(crc >> 12) ^ (data[i] & 15U)];
    }
/*- */
/*+ small */
    for (int32_t i = 0; i < count; i++) {
        crc ^= (uint32_t)data[i] << 8;
        for (int32_t bit = 0; bit < 8; bit++) {
            crc = (crc & 0x8000U) ? crc << 1 ^ 0x1021U : crc << 1;
        }
        crc &= 0xFFFFU;
    }
/*- */
    return (uint16_t)crc;
}

void innervate_seal_crc(uint8_t *data, int32_t size)
{
    const uint16_t crc = innervate_crc(data, size - 2);
    data[size - 2] = (uint8_t)(crc >> 8);
    data[size - 1] = (uint8_t)(crc & 0xFF);
}

int32_t innervate_is_sound(const uint8_t *data, int32_t size)
{
    const uint16_t crc = innervate_crc(data, size - 2);
    return data[size - 2] == crc >> 8 && data[size - 1] == (crc & 0xFF);
}

int32_t innervate_stuff(const uint8_t *data, int32_t count, uint8_t *line)
{
    int32_t code = 0;
    for (int32_t i = 0; i < count; i++) {
        if (data[i] == 0) {
            line[code] = (uint8_t)(i + 1 - code);
            code = i + 1;
        } else {
            line[i + 1] = data[i];
        }
    }
    line[code] = (uint8_t)(count + 1 - code);
    line[count + 1] = 0;
    return count + 2;
}

int32_t innervate_unstuff(uint8_t *line, int32_t count)
{
    int32_t at = 0;
    while (at < count) {
        const int32_t next = at + line[at];
        if (line[at] == 0 || next > count) {
            return -1;
        }
        line[at] = 0; /* what the code stood for; in front of the first there is nothing */
        at = next;
    }
    for (int32_t i = 1; i < count; i++) {
        line[i - 1] = line[i];
    }
    return count - 1;
}
