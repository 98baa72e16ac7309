// What a path's ray meets: of faces that coincide with its start the next in order, else what traversal finds.
#ifndef MEET_GLSL
#define MEET_GLSL

#include "path_state.glsl"

bool meet(PathState path, out Hit hit) {
    if (facesHaveOrder() && path.amongFaces) {
        hit = path.next;
        return true;
    }
    return closestHit(path.ray, hit);
}

// The surface that it met; `hit` becomes that of the first in order of those that coincide there.
Surface arrive(PathState path, inout Hit hit) {
    Surface s = surfaceAt(hit, path.ray);
    if (!facesHaveOrder()) return s;
    s.coincides = path.amongFaces;
    if (!path.amongFaces) arriveAmongFaces(s, path.ray, hit);
    return s;
}

#endif
