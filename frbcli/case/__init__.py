"""What the user wrote, frozen, in SI: the models, the loader, the shipped cases."""
