"""The recorded page as a bench: samples next to the robot, displays that follow the time, and state in the address.

`vendor` holds uPlot 1.6.32 (MIT, https://github.com/leeoniya/uPlot), which quickly draws lines of thousands of samples.
"""
