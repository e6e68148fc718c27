/* Where several sources of sound are whose energies add up at the nodes: all of them at once, by Gauss-Newton on the logarithms of the energies, with what was
 * expected of each as prior. Two sources are told apart so down to half the sensing range; more of one's own means, such as shares of the energy
 * (decomposition.h), fail below one and a half of it.
 *
 *     r_i = ln(y_i / e_i),   e_i = sum_k C / d_ik^2,   d r_i / d p_k = -2 (C / d_ik^2) (p_k - s_i) / (e_i d_ik^2),   var r_i = tau^2 + (eta / e_i)^2
 *
 * The measurements and priors decide the answer, whoever computes it: all who follow one of the sources and know the same of the others get the same. */
#ifndef MOTEHOUND_JOINT_SOURCES_H
#define MOTEHOUND_JOINT_SOURCES_H

#if MH_REAL_FIXED
#error "motehound/joint_sources.h needs MH_REAL=float: docs/fixed_point.md"
#endif

#include "motehound/config.h"
#include "motehound/sound_fix.h"

/* Iterations of mh_joint_sources at most, and the longest step of one source in one of them. */
#define MH_JOINT_ITERATIONS 5
#define MH_JOINT_STEP_M 10.0f

/* A source: where it is expected, m, and how surely (m2, positive definite). */
struct mh_source {
    struct mh_vec2 position;
    struct mh_sym2 covariance;
    uint8_t besides; /* further targets at the same place: it is so many times louder than one */
};

/* What has been found of one source. */
struct mh_source_fix {
    struct mh_vec2 position;   /* the most probable, with all priors */
    struct mh_sym2 covariance; /* of that */
    struct mh_sym2
        information; /* of the measurements alone, the other sources being as uncertain as they are: positive semidefinite */
};

/* From the priors' means, or from starts[0 .. count) unless that is NULL -> fixes[0 .. count). Energies below 1/4 count as that. At most MH_JOINT_ITERATIONS, each with
 * two divisions, a logarithm and 2 count^2 multiplications a node, and a Cholesky solution of 2 count equations.
 * Errors: MH_ERR_ARGUMENT (count not 1 to MH_SOURCES_MAX, sound not valid or without noise), MH_ERR_TOO_FEW (no node), MH_ERR_NOT_FINITE, MH_ERR_SINGULAR (a prior that is not positive
 * definite). */
enum mh_status mh_joint_sources(const struct mh_sound *sound, const struct mh_heard *heard, size_t heard_count,
                                const struct mh_source *sources, const struct mh_vec2 *starts, size_t count,
                                struct mh_source_fix *fixes);

#endif
