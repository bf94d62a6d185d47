"""Frame records to bytes and back: bit layouts, CRC. Runs on boards."""
