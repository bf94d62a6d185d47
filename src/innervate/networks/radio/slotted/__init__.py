"""The slotted level of the radio: a reference model without protocol sources."""
