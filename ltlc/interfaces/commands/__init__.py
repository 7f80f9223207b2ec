"""One module for each command of `ltlc`, imported when it is called: `run(options)` gives the exit code."""
