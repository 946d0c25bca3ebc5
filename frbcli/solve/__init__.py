"""Time integration: joins rotor and films. Depends on: scene, film, rotor, results, errors."""
