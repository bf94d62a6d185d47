/*+ min */
static int32_t role_min(int32_t a, int32_t b)
{
    return a < b ? a : b;
}
/*- */
/*+ max */
static int32_t role_max(int32_t a, int32_t b)
{
    return a > b ? a : b;
}
/*- */
/*+ abs */
static int32_t role_abs(int32_t a)
{
    return a < 0 ? -a : a;
}
/*- */
/*+ floor_div */
/* Rounds down, where `/` of C rounds towards 0; divides without signs, as all the rest. */
static int32_t role_floor_div(int32_t a, int32_t b)
{
    if (b < 0) {
        a = -a;
        b = -b;
    }
    if (a < 0) {
        return -1 - (int32_t)((uint32_t)(-1 - a) / (uint32_t)b);
    }
    return (int32_t)((uint32_t)a / (uint32_t)b);
}
/*- */
/*+ floor_mod */
/* What is left of a behind floor_div: never negative where b is not. */
static int32_t role_floor_mod(int32_t a, int32_t b)
{
    return a - role_floor_div(a, b) * b;
}
/*- */
/*+ zero */
static void role_zero(void *record, uint32_t size)
{
    for (uint32_t i = 0; i < size; i++) {
        ((uint8_t *)record)[i] = 0;
    }
}
/*- */
