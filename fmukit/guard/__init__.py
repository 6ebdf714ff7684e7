"""Foreign code in a process of its own that cannot outlive its welcome: bounded, watched, ended with all descendants.

`Guarded` starts a command under a small keeper process, which adopts whatever the command leaves behind (a subreaper
on Linux), holds it to `Limits` and ends it all when the command ends, when it is told to, or when its owner dies. A
fence (Landlock, on Linux) keeps its files and its signals to itself. `Stopwatch` tells the time such a process really
had from the time it waited for a busy machine. Without a fence, code that runs with the user's rights can end any
process of the user, this one included.
"""
