// Declarations that graphics stages share: the frame, the push constants, and vertices pulled from buffers.
#extension GL_GOOGLE_include_directive : require
#include "frame_params.h"

layout(std140, set = 0, binding = kBindFrame) uniform Frame {
    FrameParams frame;
};
layout(push_constant) uniform Push {
    PushParams push;
};
