// Surfaces of schemes, as implementations of the C interface have them. Not part of the public interface.
#pragma once

#include "limn/c/interop.h"
#include "limn/c/limn_schemes.h"
#include "limn/schemes/scheme_surface.h"

struct limn_scheme_surface {
    limn::SchemeSurface value;
    uint32_t level;
    bool reached;
    double tolerance;
    limn::Array<uint8_t> face_levels;  ///< of adaptive ones
};
