"""Pages for a browser that need nothing else: what a run has shown, drawn over the signals."""
