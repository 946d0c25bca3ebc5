"""The gate that every case passes before a film is made: each rule stands once, with the analyses that it holds for."""
