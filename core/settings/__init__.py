"""Algorithm settings: frozen, versioned, every option with meaning, unit, default and source."""

from core.settings.declared import declared_values, only_declared
from core.settings.presets import PRESET_NAMES, Settings, make_settings, option_names, preset_values

__all__ = [
    "PRESET_NAMES",
    "Settings",
    "declared_values",
    "make_settings",
    "only_declared",
    "option_names",
    "preset_values",
]
