"""What is read of a state: summary, stations, energies, forces, rates."""
