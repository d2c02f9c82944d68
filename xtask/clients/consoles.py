"""Pronsole without a user."""

import os
import sys
import time
import types


def pronsole_class(folder):
    """Pronsole, without wxPython, which its settings ask for even where there is no window, and with files of its own in
    `folder`, not in the user's."""
    for name in ["wx", "printrun.gui", "printrun.gui.widgets", "platformdirs"]:
        sys.modules[name] = types.ModuleType(name)
    sys.modules["printrun.gui.widgets"].get_space = lambda key: 0
    for name in ["user_cache_dir", "user_config_dir", "user_data_dir"]:
        setattr(sys.modules["platformdirs"], name, lambda application: os.path.join(folder, application))
    from printrun.pronsole import pronsole

    return pronsole


def leave(host):
    """Ends a console and its connection."""
    host.statuscheck = False
    if host.p.printing:
        host.p.cancelprint()
    while not (host.p.send_thread and host.p.send_thread.is_alive()):
        time.sleep(0.01)
    host.p.disconnect()
