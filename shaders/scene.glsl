// Declarations that graphics stages share: the frame, the push constants, and vertices pulled from buffers.
#extension GL_GOOGLE_include_directive : require
#include "frame_params.h"

// Beside limn's stages of hardware tessellation, set 0 and the push constants are theirs.
#ifdef LIMN_HARDWARE
#define SCENE_SET 1
#else
#define SCENE_SET 0
layout(push_constant) uniform Push {
    PushParams push;
};
#endif

layout(std140, set = SCENE_SET, binding = kBindFrame) uniform Frame {
    FrameParams frame;
};
