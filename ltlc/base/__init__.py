"""What every room may use: places in text, findings, fixes, files, limits, and how findings are shown."""
