#pragma once

/// From now on SIGINT, SIGTERM and SIGHUP remove what is half written before they end the process. Call it before any
/// thread is started.
void end_cleanly_on_signals();
