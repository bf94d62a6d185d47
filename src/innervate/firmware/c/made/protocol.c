/* @name: made from @entry, function by function.
 * Above each stands where it was made from. Do not edit: edit that. */
#include "@header"

/* Sums of two values below 2^30 must fit into an int, and >> must keep the sign. */
typedef char role_int_has_32_bits[
        (sizeof(int) >= 4 && (-1 >> 1) == -1) ? 1 : -1];

@functions
