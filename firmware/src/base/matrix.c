#include "motehound/matrix.h"

/* Start of row i of the packed lower triangle. */
static int row_start(int i) { return i * (i + 1) / 2; }

enum mh_status mh_cholesky_factor(int n, mh_real *a)
{
    for (int i = 0; i < n; i++) {
        mh_real *row = a + row_start(i);
        const mh_real diagonal = row[i];
        for (int j = 0; j <= i; j++) {
            const mh_real *other = a + row_start(j);
            mh_real sum = row[j];
            for (int k = 0; k < j; k++) {
                sum -= row[k] * other[k];
            }
            if (j < i) {
                row[j] = sum / other[j];
            } else if (sum > 1e-7f * diagonal && mh_finite(sum)) {
                row[i] = mh_sqrt(sum);
            } else {
                return MH_ERR_SINGULAR;
            }
        }
    }
    return MH_OK;
}

void mh_cholesky_solve(int n, const mh_real *l, mh_real *b)
{
    for (int i = 0; i < n; i++) {
        const mh_real *row = l + row_start(i);
        for (int k = 0; k < i; k++) {
            b[i] -= row[k] * b[k];
        }
        b[i] /= row[i];
    }
    for (int i = n - 1; i >= 0; i--) {
        const mh_real *row = l + row_start(i);
        b[i] /= row[i];
        for (int k = 0; k < i; k++) {
            b[k] -= row[k] * b[i];
        }
    }
}

void mh_cholesky_invert(int n, mh_real *l)
{
    /* M = L^-1, row by row: row i of M needs row i of L and the rows of M above */
    for (int i = 0; i < n; i++) {
        mh_real *row = l + row_start(i);
        const mh_real reciprocal = 1.0f / row[i];
        for (int j = 0; j < i; j++) {
            mh_real sum = 0.0f;
            for (int k = j; k < i; k++) {
                sum += row[k] * l[row_start(k) + j];
            }
            row[j] = -sum * reciprocal;
        }
        row[i] = reciprocal;
    }
    /* A^-1 = M' M: element (i, j) needs columns i and j from row i on, which are still untouched when taken in this order */
    for (int i = 0; i < n; i++) {
        for (int j = 0; j <= i; j++) {
            mh_real sum = 0.0f;
            for (int k = i; k < n; k++) {
                sum += l[row_start(k) + i] * l[row_start(k) + j];
            }
            l[row_start(i) + j] = sum;
        }
    }
}
