"""Babel [RFC 8966] over cables: a distance-vector protocol of the field, beside the skin."""
