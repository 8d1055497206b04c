#pragma once

/// From now on SIGINT, SIGTERM and SIGHUP remove what is half written before they end the process. Call it before any
/// thread is started.
void end_cleanly_on_signals();

/// From now on the first of these signals only asks for the end: the command is to finish what it is at. The second
/// ends the process as before.
void ask_before_ending_on_signals();
bool is_end_requested();
