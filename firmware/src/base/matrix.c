#include "motehound/matrix.h"

/* Start of row i of the packed lower triangle. */
static int row_start(int i) { return i * (i + 1) / 2; }

/* Row by row. A pivot below `floor` of its diagonal element is raised to that if it is at least `lowest` of it. */
static enum mh_status factor(int n, mh_real *a, mh_real floor, mh_real lowest, bool *raised)
{
    for (int i = 0; i < n; i++) {
        mh_real *row = a + row_start(i);
        const mh_real diagonal = row[i];
        for (int j = 0; j < i; j++) {
            const mh_real *other = a + row_start(j);
            mh_real sum = row[j];
            for (int k = 0; k < j; k++) {
                sum -= row[k] * other[k];
            }
            row[j] = sum / other[j];
        }
        mh_real pivot = diagonal;
        for (int k = 0; k < i; k++) {
            pivot -= row[k] * row[k];
        }
        if (!(pivot > floor * diagonal)) {
            if (!(pivot > lowest * diagonal)) {
                return MH_ERR_SINGULAR;
            }
            pivot = floor * diagonal;
            *raised = true;
        }
        if (!(pivot > 0) || !mh_finite(pivot)) {
            return MH_ERR_SINGULAR;
        }
        row[i] = mh_sqrt(pivot);
    }
    return MH_OK;
}

enum mh_status mh_cholesky_factor(int n, mh_real *a)
{
    bool raised;
    return factor(n, a, 1e-7f, 1e-7f, &raised);
}

enum mh_status mh_cholesky_factor_raised(int n, mh_real *a, bool *raised)
{
    *raised = false;
    return factor(n, a, MH_PIVOT_FLOOR, -16.0f * MH_PIVOT_FLOOR, raised);
}

void mh_cholesky_multiply(int n, mh_real *l)
{
    /* element (i, j) needs rows i and j up to column j, which are still untouched when taken in this order */
    for (int i = n - 1; i >= 0; i--) {
        mh_real *row = l + row_start(i);
        const mh_real *other = row;
        for (int j = i; j >= 0; j--) {
            mh_real sum = 0.0f;
            for (int k = 0; k <= j; k++) {
                sum += row[k] * other[k];
            }
            row[j] = sum;
            other -= j;
        }
    }
}

void mh_lower_multiply(int n, const mh_real *l, mh_real *b)
{
    for (int i = n - 1; i >= 0; i--) {
        const mh_real *row = l + row_start(i);
        mh_real sum = 0.0f;
        for (int k = 0; k <= i; k++) {
            sum += row[k] * b[k];
        }
        b[i] = sum;
    }
}

void mh_lower_solve(int n, const mh_real *l, mh_real *b)
{
    for (int i = 0; i < n; i++) {
        for (int k = 0; k < i; k++) {
            b[i] -= l[k] * b[k];
        }
        b[i] /= l[i];
        l += i + 1;
    }
}

void mh_cholesky_solve(int n, const mh_real *l, mh_real *b)
{
    mh_lower_solve(n, l, b);
    for (int i = n - 1; i >= 0; i--) {
        const mh_real *row = l + row_start(i);
        b[i] /= row[i];
        for (int k = 0; k < i; k++) {
            b[k] -= row[k] * b[i];
        }
    }
}

void mh_cholesky_invert_factor(int n, mh_real *l)
{
    /* row i of L^-1 needs row i of L and the rows of L^-1 above */
    mh_real *row = l;
    for (int i = 0; i < n; i++) {
        const mh_real reciprocal = 1.0f / row[i];
        const mh_real *diagonal = l;
        for (int j = 0; j < i; j++) {
            const mh_real *above = diagonal; /* down column j */
            mh_real sum = 0.0f;
            for (int k = j; k < i; k++) {
                sum += row[k] * *above;
                above += k + 1;
            }
            row[j] = -sum * reciprocal;
            diagonal += j + 2;
        }
        row[i] = reciprocal;
        row += i + 1;
    }
}

void mh_cholesky_invert(int n, mh_real *l)
{
    /* A^-1 = M' M, M = L^-1: element (i, j) needs columns i and j from row i on, which are still untouched when taken in this order */
    mh_cholesky_invert_factor(n, l);
    mh_real *from = l;
    for (int i = 0; i < n; i++) {
        for (int j = 0; j <= i; j++) {
            const mh_real *row = from;
            mh_real sum = 0.0f;
            for (int k = i; k < n; k++) {
                sum += row[i] * row[j];
                row += k + 1;
            }
            from[j] = sum;
        }
        from += i + 1;
    }
}
