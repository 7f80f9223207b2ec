"""What all rooms may use: places in text, findings, mends, files, limits, and how findings are shown."""
