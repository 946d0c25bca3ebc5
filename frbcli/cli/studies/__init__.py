"""Commands that study a machine or a bearing, or use a measurement."""
