"""What the user wrote, frozen, in SI: the models, the loader, the cases that come along."""
