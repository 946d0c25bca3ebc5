"""Pictures of results, one per file; matplotlib lives here only."""

import os

from frbcli.caches import temporary_cache

if not {"MPLCONFIGDIR", "XDG_CONFIG_HOME", "XDG_CACHE_HOME"} & set(os.environ) and not os.access(
    os.path.expanduser("~"), os.W_OK
):
    os.environ["MPLCONFIGDIR"] = str(temporary_cache())  # else matplotlib says so in three lines, at every start
