"""Natural frequencies and shapes of trees and networks: counts, enclosures, damped modes, variants. Arrays only."""
