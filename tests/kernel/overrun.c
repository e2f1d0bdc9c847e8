/* Reads one double beyond an array: what a sanitizer must find, for test_sanitizers.py. */
double mr_sum_and_one_more(const double *x, int count);

double mr_sum_and_one_more(const double *x, int count) {
    double sum = 0.0;
    for (int i = 0; i <= count; ++i) sum += x[i];
    return sum;
}
