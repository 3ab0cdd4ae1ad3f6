// The instance that a face belongs to, and what the caller's buffer says of it. Before it: tess_bindings.glsl. Dispatches of
// one that has no such buffer are told by kNoFace in place of where instances begin.

layout(std430, binding = kTessOutBinding) readonly buffer Instances { TessInstance instances[]; };

// Of the table's instances (at: their count, the first face of each and the end of the last, the number of each), the last that
// begins at or before the face: those without faces come before it.
uint instance_of(uint at, uint face) {
    const uint count = WORD(at);
    uint low = 0, high = count;
    while (high - low > 1) {
        const uint middle = (low + high) / 2;
        if (WORD(at + 1 + middle) <= face)
            low = middle;
        else
            high = middle;
    }
    return WORD(at + 2 + count + low);
}

vec4 world_row(uint instance, uint i) {
    return vec4(instances[instance].object_to_world[4 * i], instances[instance].object_to_world[4 * i + 1],
                instances[instance].object_to_world[4 * i + 2], instances[instance].object_to_world[4 * i + 3]);
}
vec3 to_world(uint instance, vec3 p) {
    return vec3(dot(world_row(instance, 0), vec4(p, 1)), dot(world_row(instance, 1), vec4(p, 1)),
                dot(world_row(instance, 2), vec4(p, 1)));
}
// Planes and eyes the other way: from the world's coordinates to the object's.
vec4 plane_to_object(uint instance, vec4 plane) {
    return plane.x * world_row(instance, 0) + plane.y * world_row(instance, 1) + plane.z * world_row(instance, 2) +
           vec4(0, 0, 0, plane.w);
}
// w is 1, or 0 of an eye infinitely far away. Of a transform that is flat, nothing is far from the eye.
vec4 eye_to_object(uint instance, vec4 eye) {
    const vec4 x = world_row(instance, 0), y = world_row(instance, 1), z = world_row(instance, 2);
    const vec3 yz = cross(y.xyz, z.xyz), zx = cross(z.xyz, x.xyz), xy = cross(x.xyz, y.xyz);
    const vec3 to = eye.xyz - eye.w * vec3(x.w, y.w, z.w);
    const float volume = dot(x.xyz, yz);
    return volume != 0 ? vec4((to.x * yz + to.y * zx + to.z * xy) / volume, eye.w) : vec4(0);
}
