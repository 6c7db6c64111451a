"""The only door to heyoka, the Taylor integrator that compiles the equations of a scene.

heyoka's traps are dealt with here: constants enter in the run's own precision and never as Python floats; log lines,
its only sign of a lost root, are caught; outcome codes are checked; arrays of `real` leak without the custom memory
handler; the disk cache never hits beyond 128 bits and is switched off for `real`.
"""
