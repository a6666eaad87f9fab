"""The recorded page as a bench: the samples beside the robot, what follows the time, and what an address keeps.

`vendor` holds uPlot 1.6.32 (MIT, https://github.com/leeoniya/uPlot), that draws lines of thousands of samples quickly.
"""
