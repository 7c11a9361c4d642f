"""Algorithm settings: frozen, versioned, every option with meaning, unit, default and source."""

from core.settings.presets import PRESET_NAMES, Settings, make_settings, option_names, preset_values

__all__ = ["PRESET_NAMES", "Settings", "make_settings", "option_names", "preset_values"]
