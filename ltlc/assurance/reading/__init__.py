"""Reading back: the step functions as emitted are parsed again and shown to be the monitor, letter by letter."""
