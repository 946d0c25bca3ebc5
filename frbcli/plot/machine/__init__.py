"""Pictures of bearings, modes, stability and limit cycles."""
