#pragma once

/// From now on SIGINT, SIGTERM and SIGHUP remove what is half written before they end the process. Call it before any
/// thread is started.
void end_cleanly_on_signals();

/// From now on the first of these signals only asks for the end: the command is to finish what it is at. The second
/// ends the process as before.
void ask_before_ending_on_signals();
bool is_end_requested();

/// From now on a reader of standard output or of a pipe that goes away does not end the process; writing fails instead,
/// so that files that are only whole when they are closed can be.
void outlive_readers();
