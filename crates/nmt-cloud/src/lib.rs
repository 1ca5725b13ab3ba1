//! Clouds of nodes, regular or randomly irregular, on a 2D section.
